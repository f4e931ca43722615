"""The sealed race of `bondgraph.discover`: machines with hidden effects, and what it says of them.

`truth` simulates, `entries` lists what is hidden where, `cases` makes recordings and a sealed file,
`runner` asks for an answer to each, `score` opens the seal.
"""
