/* copies_2_coupled: 4 cells
 * made by planner-reactor lts
 * port 0: take_left
 * port 1: take_right
 * port 2: give_right
 * port 3: give_left
 * value 0: 1
 */
chan port_0 = [0] of { byte };
chan port_1 = [0] of { byte };
chan port_2 = [0] of { byte };
chan port_3 = [0] of { byte };

active proctype cell_1() {
at_0:
  if
  :: true -> goto at_1 /* Want */
  :: true -> goto at_2 /* WAITINHIBIT[a1] waits */
  fi;
at_1:
  if
  :: true -> goto at_3 /* ASSERT[a1] waits */
  :: true -> goto at_4 /* WAITINHIBIT[a1] waits */
  fi;
at_2:
  if
  :: true -> goto at_4 /* Want */
  :: true -> goto at_5 /* KILL[12] */
  fi;
at_3:
  if
  :: true -> goto at_6 /* SIT[a1]<1> */
  :: true -> goto at_7 /* WAITINHIBIT[a1] waits */
  fi;
at_4:
  if
  :: true -> goto at_8 /* ASSERT[a1] waits */
  :: true -> goto at_9 /* KILL[12] */
  fi;
at_5:
  if
  :: true -> goto at_9 /* Want */
  :: true -> goto at_10 /* KILL[13] */
  fi;
at_6:
  if
  :: true -> goto at_11 /* ASSERT[b1] waits */
  :: true -> goto at_12 /* WAITINHIBIT[a1] waits */
  fi;
at_7:
  if
  :: true -> goto at_12 /* SIT[a1]<1> */
  fi;
at_8:
  if
  :: true -> goto at_13 /* KILL[12] */
  fi;
at_9:
  if
  :: true -> goto at_13 /* ASSERT[a1] waits */
  :: true -> goto at_14 /* KILL[13] */
  fi;
at_10:
  if
  :: true -> goto at_14 /* Want */
  :: true -> goto at_15 /* UNINHIBIT[a1] */
  fi;
at_11:
  if
  :: true -> goto at_16 /* SIT[b1]<2> */
  :: true -> goto at_17 /* WAITINHIBIT[a1] waits */
  fi;
at_12:
  if
  :: true -> goto at_17 /* ASSERT[b1] waits */
  fi;
at_13:
  if
  :: true -> goto at_18 /* KILL[13] */
  fi;
at_14:
  if
  :: true -> goto at_18 /* ASSERT[a1] waits */
  :: true -> goto at_19 /* UNINHIBIT[a1] */
  fi;
at_15:
  if
  :: true -> goto at_19 /* Want */
  fi;
at_16:
  if
  :: true -> goto at_20 /* WAITINHIBIT[a1] waits */
  :: port_0!0 -> goto at_21
  fi;
at_17:
  if
  :: true -> goto at_20 /* SIT[b1]<2> */
  fi;
at_18:
  if
  :: true -> goto at_22 /* UNINHIBIT[a1] */
  fi;
at_19:
  if
  :: true -> goto at_22 /* ASSERT[a1] waits */
  fi;
at_20:
  if
  :: port_0!0 -> goto at_23
  fi;
at_21:
  if
  :: true -> goto at_23 /* WAITINHIBIT[a1] waits */
  :: port_1!0 -> goto at_24
  fi;
at_22:
  if
  :: true -> goto at_25 /* SIT[a1]<1> */
  fi;
at_23:
  if
  :: port_1!0 -> goto at_26
  fi;
at_24:
  if
  :: true -> goto at_27 /* Work */
  :: true -> goto at_27 /* Work aborts */
  :: true -> goto at_26 /* WAITINHIBIT[a1] waits */
  fi;
at_25:
  if
  :: true -> goto at_28 /* ASSERT[x1] waits */
  fi;
at_26:
  if
  :: true -> goto at_29 /* Work */
  :: true -> goto at_29 /* Work aborts */
  fi;
at_27:
  if
  :: true -> goto at_29 /* WAITINHIBIT[a1] waits */
  :: port_2!0 -> goto at_30
  fi;
at_28:
  if
  :: true -> goto at_31 /* SIT[x1]<2> */
  fi;
at_29:
  if
  :: port_2!0 -> goto at_32
  fi;
at_30:
  if
  :: true -> goto at_32 /* WAITINHIBIT[a1] waits */
  :: port_3!0 -> goto at_33
  fi;
at_31:
  if
  :: port_0!0 -> goto at_34
  fi;
at_32:
  if
  :: port_3!0 -> goto at_35
  fi;
at_33:
  if
  :: true -> goto at_36 /* SUCCEED[b1, 2] */
  :: true -> goto at_35 /* WAITINHIBIT[a1] waits */
  fi;
at_34:
  if
  :: port_1!0 -> goto at_37
  fi;
at_35:
  if
  :: true -> goto at_38 /* SUCCEED[b1, 2] */
  fi;
at_36:
  if
  :: true -> goto at_0 /* SUCCEED[a1, 1] */
  :: true -> goto at_38 /* WAITINHIBIT[a1] waits */
  fi;
at_37:
  if
  :: true -> goto at_39 /* Work */
  :: true -> goto at_39 /* Work aborts */
  fi;
at_38:
  if
  :: true -> goto at_2 /* SUCCEED[a1, 1] */
  fi;
at_39:
  if
  :: port_2!0 -> goto at_40
  fi;
at_40:
  if
  :: port_3!0 -> goto at_41
  fi;
at_41:
  if
  :: true -> goto at_42 /* SUCCEED[x1, 2] */
  fi;
at_42:
  if
  :: true -> goto at_43 /* ASSERT[y1] waits */
  fi;
at_43:
  if
  :: true -> goto at_44 /* SIT[y1]<2> */
  fi;
at_44:
  if
  :: port_0!0 -> goto at_45
  fi;
at_45:
  if
  :: port_1!0 -> goto at_46
  fi;
at_46:
  if
  :: true -> goto at_47 /* Work */
  :: true -> goto at_47 /* Work aborts */
  fi;
at_47:
  if
  :: port_2!0 -> goto at_48
  fi;
at_48:
  if
  :: port_3!0 -> goto at_49
  fi;
at_49:
  if
  :: true -> goto at_50 /* SUCCEED[y1, 2] */
  fi;
at_50:
  if
  :: true -> goto at_15 /* SUCCEED[a1, 1] */
  fi;
}

active proctype cell_2() {
at_0:
  if
  :: true -> goto at_1 /* Want */
  :: true -> goto at_2 /* WAITINHIBIT[a2] waits */
  fi;
at_1:
  if
  :: true -> goto at_3 /* ASSERT[a2] waits */
  :: true -> goto at_4 /* WAITINHIBIT[a2] waits */
  fi;
at_2:
  if
  :: true -> goto at_4 /* Want */
  :: true -> goto at_5 /* KILL[22] */
  fi;
at_3:
  if
  :: true -> goto at_6 /* SIT[a2]<1> */
  :: true -> goto at_7 /* WAITINHIBIT[a2] waits */
  fi;
at_4:
  if
  :: true -> goto at_8 /* ASSERT[a2] waits */
  :: true -> goto at_9 /* KILL[22] */
  fi;
at_5:
  if
  :: true -> goto at_9 /* Want */
  :: true -> goto at_10 /* KILL[23] */
  fi;
at_6:
  if
  :: true -> goto at_11 /* ASSERT[b2] waits */
  :: true -> goto at_12 /* WAITINHIBIT[a2] waits */
  fi;
at_7:
  if
  :: true -> goto at_12 /* SIT[a2]<1> */
  fi;
at_8:
  if
  :: true -> goto at_13 /* KILL[22] */
  fi;
at_9:
  if
  :: true -> goto at_13 /* ASSERT[a2] waits */
  :: true -> goto at_14 /* KILL[23] */
  fi;
at_10:
  if
  :: true -> goto at_14 /* Want */
  :: true -> goto at_15 /* UNINHIBIT[a2] */
  fi;
at_11:
  if
  :: true -> goto at_16 /* SIT[b2]<2> */
  :: true -> goto at_17 /* WAITINHIBIT[a2] waits */
  fi;
at_12:
  if
  :: true -> goto at_17 /* ASSERT[b2] waits */
  fi;
at_13:
  if
  :: true -> goto at_18 /* KILL[23] */
  fi;
at_14:
  if
  :: true -> goto at_18 /* ASSERT[a2] waits */
  :: true -> goto at_19 /* UNINHIBIT[a2] */
  fi;
at_15:
  if
  :: true -> goto at_19 /* Want */
  fi;
at_16:
  if
  :: true -> goto at_20 /* WAITINHIBIT[a2] waits */
  :: port_1!0 -> goto at_21
  fi;
at_17:
  if
  :: true -> goto at_20 /* SIT[b2]<2> */
  fi;
at_18:
  if
  :: true -> goto at_22 /* UNINHIBIT[a2] */
  fi;
at_19:
  if
  :: true -> goto at_22 /* ASSERT[a2] waits */
  fi;
at_20:
  if
  :: port_1!0 -> goto at_23
  fi;
at_21:
  if
  :: true -> goto at_23 /* WAITINHIBIT[a2] waits */
  :: port_0!0 -> goto at_24
  fi;
at_22:
  if
  :: true -> goto at_25 /* SIT[a2]<1> */
  fi;
at_23:
  if
  :: port_0!0 -> goto at_26
  fi;
at_24:
  if
  :: true -> goto at_27 /* Work */
  :: true -> goto at_27 /* Work aborts */
  :: true -> goto at_26 /* WAITINHIBIT[a2] waits */
  fi;
at_25:
  if
  :: true -> goto at_28 /* ASSERT[x2] waits */
  fi;
at_26:
  if
  :: true -> goto at_29 /* Work */
  :: true -> goto at_29 /* Work aborts */
  fi;
at_27:
  if
  :: true -> goto at_29 /* WAITINHIBIT[a2] waits */
  :: port_3!0 -> goto at_30
  fi;
at_28:
  if
  :: true -> goto at_31 /* SIT[x2]<2> */
  fi;
at_29:
  if
  :: port_3!0 -> goto at_32
  fi;
at_30:
  if
  :: true -> goto at_32 /* WAITINHIBIT[a2] waits */
  :: port_2!0 -> goto at_33
  fi;
at_31:
  if
  :: port_1!0 -> goto at_34
  fi;
at_32:
  if
  :: port_2!0 -> goto at_35
  fi;
at_33:
  if
  :: true -> goto at_36 /* SUCCEED[b2, 2] */
  :: true -> goto at_35 /* WAITINHIBIT[a2] waits */
  fi;
at_34:
  if
  :: port_0!0 -> goto at_37
  fi;
at_35:
  if
  :: true -> goto at_38 /* SUCCEED[b2, 2] */
  fi;
at_36:
  if
  :: true -> goto at_0 /* SUCCEED[a2, 1] */
  :: true -> goto at_38 /* WAITINHIBIT[a2] waits */
  fi;
at_37:
  if
  :: true -> goto at_39 /* Work */
  :: true -> goto at_39 /* Work aborts */
  fi;
at_38:
  if
  :: true -> goto at_2 /* SUCCEED[a2, 1] */
  fi;
at_39:
  if
  :: port_3!0 -> goto at_40
  fi;
at_40:
  if
  :: port_2!0 -> goto at_41
  fi;
at_41:
  if
  :: true -> goto at_42 /* SUCCEED[x2, 2] */
  fi;
at_42:
  if
  :: true -> goto at_43 /* ASSERT[y2] waits */
  fi;
at_43:
  if
  :: true -> goto at_44 /* SIT[y2]<2> */
  fi;
at_44:
  if
  :: port_1!0 -> goto at_45
  fi;
at_45:
  if
  :: port_0!0 -> goto at_46
  fi;
at_46:
  if
  :: true -> goto at_47 /* Work */
  :: true -> goto at_47 /* Work aborts */
  fi;
at_47:
  if
  :: port_3!0 -> goto at_48
  fi;
at_48:
  if
  :: port_2!0 -> goto at_49
  fi;
at_49:
  if
  :: true -> goto at_50 /* SUCCEED[y2, 2] */
  fi;
at_50:
  if
  :: true -> goto at_15 /* SUCCEED[a2, 1] */
  fi;
}

active proctype cell_3() {
at_0:
  if
  :: port_0?0 -> goto at_1
  fi;
at_1:
  if
  :: port_3?0 -> goto at_0
  fi;
}

active proctype cell_4() {
at_0:
  if
  :: port_1?0 -> goto at_1
  fi;
at_1:
  if
  :: port_2?0 -> goto at_0
  fi;
}
