"""The parameter study: which settings of the fusion matter, which interact, is the default good."""
