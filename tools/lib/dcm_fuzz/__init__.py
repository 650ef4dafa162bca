"""Looks for inputs on which the package does neither right nor say what is wrong; tools/fuzz.

grammar: random decks; mutate: damaged files; seeds: the whole files that are damaged; cases: what
each kind of case is made of; judge: runs one and says how it ended; minimize: the smallest input
that fails alike; __main__: the loop, its folder and its table.
"""
