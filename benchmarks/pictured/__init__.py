"""Pictures of the model: each made by the code itself on a simulated scene."""
