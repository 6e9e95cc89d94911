"""What the benchmark of rules is made of: scenes with labelled episodes, and their judging."""
