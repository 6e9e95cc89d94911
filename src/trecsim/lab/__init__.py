"""The laboratory: how we know what the product does. The product never imports it."""
