"""The algebra's laws as data, the random terms that they are tried on, and the search for counterexamples."""
