"""What the pictures of the operator page are made of: a simulated site, states, a browser."""
