"""What rules look for: one small condition for each kind, all behind one Protocol."""
