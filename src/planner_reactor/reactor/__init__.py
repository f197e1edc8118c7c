"""The reactor: what always runs, planner or no planner, and is changed only by safe adaptation (R §5).

Where to look: `situations` is the store of situation instances; `controls`, `guards` and `monitors` are the built-in
processes that programs use on it (R Tables 1 and 2, §8.3); `structure` reads a reactor's shape off its text;
`admission` checks an adaptation, `adaptation` runs it as a transaction; `laws` are asked after every event;
`reactor` is the face of it all. Nothing here knows the planner or the logic.
"""
