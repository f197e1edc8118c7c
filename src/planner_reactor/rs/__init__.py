"""The language RS: terms, grammar, parser, printer, static checks and the one-step rules (`evolves`).

RS is the process algebra in which reactors, and the models of what surrounds them, are written (R §4, X
§4.1). A text goes through `loading` (`parser` with `grammar`, then `scope`, then `checks`) to a
`terms.Program`; `printer` writes any term back as text. Nothing here knows clocks, threads, input and output,
or the reactor.
"""
