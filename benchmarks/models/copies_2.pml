/* copies_2: 2 cells
 * made by planner-reactor lts
 */

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
  :: true -> goto at_20 /* Work */
  :: true -> goto at_21 /* Work aborts */
  :: true -> goto at_22 /* WAITINHIBIT[a1] waits */
  fi;
at_17:
  if
  :: true -> goto at_22 /* SIT[b1]<2> */
  fi;
at_18:
  if
  :: true -> goto at_23 /* UNINHIBIT[a1] */
  fi;
at_19:
  if
  :: true -> goto at_23 /* ASSERT[a1] waits */
  fi;
at_20:
  if
  :: true -> goto at_24 /* SUCCEED[b1, 2] */
  :: true -> goto at_25 /* WAITINHIBIT[a1] waits */
  fi;
at_21:
  if
  :: true -> goto at_26 /* FAIL[b1, 2] */
  :: true -> goto at_27 /* WAITINHIBIT[a1] waits */
  fi;
at_22:
  if
  :: true -> goto at_25 /* Work */
  :: true -> goto at_27 /* Work aborts */
  fi;
at_23:
  if
  :: true -> goto at_28 /* SIT[a1]<1> */
  fi;
at_24:
  if
  :: true -> goto at_0 /* SUCCEED[a1, 1] */
  :: true -> goto at_29 /* WAITINHIBIT[a1] waits */
  fi;
at_25:
  if
  :: true -> goto at_29 /* SUCCEED[b1, 2] */
  fi;
at_26:
  if
  :: true -> goto at_0 /* FAIL[a1, 1] */
  :: true -> goto at_30 /* WAITINHIBIT[a1] waits */
  fi;
at_27:
  if
  :: true -> goto at_30 /* FAIL[b1, 2] */
  fi;
at_28:
  if
  :: true -> goto at_31 /* ASSERT[x1] waits */
  fi;
at_29:
  if
  :: true -> goto at_2 /* SUCCEED[a1, 1] */
  fi;
at_30:
  if
  :: true -> goto at_2 /* FAIL[a1, 1] */
  fi;
at_31:
  if
  :: true -> goto at_32 /* SIT[x1]<2> */
  fi;
at_32:
  if
  :: true -> goto at_33 /* Work */
  :: true -> goto at_34 /* Work aborts */
  fi;
at_33:
  if
  :: true -> goto at_35 /* SUCCEED[x1, 2] */
  fi;
at_34:
  if
  :: true -> goto at_36 /* FAIL[x1, 2] */
  fi;
at_35:
  if
  :: true -> goto at_37 /* ASSERT[y1] waits */
  fi;
at_36:
  if
  :: true -> goto at_15 /* FAIL[a1, 1] */
  fi;
at_37:
  if
  :: true -> goto at_38 /* SIT[y1]<2> */
  fi;
at_38:
  if
  :: true -> goto at_39 /* Work */
  :: true -> goto at_40 /* Work aborts */
  fi;
at_39:
  if
  :: true -> goto at_41 /* SUCCEED[y1, 2] */
  fi;
at_40:
  if
  :: true -> goto at_36 /* FAIL[y1, 2] */
  fi;
at_41:
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
  :: true -> goto at_20 /* Work */
  :: true -> goto at_21 /* Work aborts */
  :: true -> goto at_22 /* WAITINHIBIT[a2] waits */
  fi;
at_17:
  if
  :: true -> goto at_22 /* SIT[b2]<2> */
  fi;
at_18:
  if
  :: true -> goto at_23 /* UNINHIBIT[a2] */
  fi;
at_19:
  if
  :: true -> goto at_23 /* ASSERT[a2] waits */
  fi;
at_20:
  if
  :: true -> goto at_24 /* SUCCEED[b2, 2] */
  :: true -> goto at_25 /* WAITINHIBIT[a2] waits */
  fi;
at_21:
  if
  :: true -> goto at_26 /* FAIL[b2, 2] */
  :: true -> goto at_27 /* WAITINHIBIT[a2] waits */
  fi;
at_22:
  if
  :: true -> goto at_25 /* Work */
  :: true -> goto at_27 /* Work aborts */
  fi;
at_23:
  if
  :: true -> goto at_28 /* SIT[a2]<1> */
  fi;
at_24:
  if
  :: true -> goto at_0 /* SUCCEED[a2, 1] */
  :: true -> goto at_29 /* WAITINHIBIT[a2] waits */
  fi;
at_25:
  if
  :: true -> goto at_29 /* SUCCEED[b2, 2] */
  fi;
at_26:
  if
  :: true -> goto at_0 /* FAIL[a2, 1] */
  :: true -> goto at_30 /* WAITINHIBIT[a2] waits */
  fi;
at_27:
  if
  :: true -> goto at_30 /* FAIL[b2, 2] */
  fi;
at_28:
  if
  :: true -> goto at_31 /* ASSERT[x2] waits */
  fi;
at_29:
  if
  :: true -> goto at_2 /* SUCCEED[a2, 1] */
  fi;
at_30:
  if
  :: true -> goto at_2 /* FAIL[a2, 1] */
  fi;
at_31:
  if
  :: true -> goto at_32 /* SIT[x2]<2> */
  fi;
at_32:
  if
  :: true -> goto at_33 /* Work */
  :: true -> goto at_34 /* Work aborts */
  fi;
at_33:
  if
  :: true -> goto at_35 /* SUCCEED[x2, 2] */
  fi;
at_34:
  if
  :: true -> goto at_36 /* FAIL[x2, 2] */
  fi;
at_35:
  if
  :: true -> goto at_37 /* ASSERT[y2] waits */
  fi;
at_36:
  if
  :: true -> goto at_15 /* FAIL[a2, 1] */
  fi;
at_37:
  if
  :: true -> goto at_38 /* SIT[y2]<2> */
  fi;
at_38:
  if
  :: true -> goto at_39 /* Work */
  :: true -> goto at_40 /* Work aborts */
  fi;
at_39:
  if
  :: true -> goto at_41 /* SUCCEED[y2, 2] */
  fi;
at_40:
  if
  :: true -> goto at_36 /* FAIL[y2, 2] */
  fi;
at_41:
  if
  :: true -> goto at_15 /* SUCCEED[a2, 1] */
  fi;
}
