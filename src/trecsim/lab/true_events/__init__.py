"""What truly happens in a simulated scene: the events that rules should tell.

This is a second, naive reading of the definitions of the rules, on the exact joints. It shares no
code with `trecsim.safety`, so that the one can be checked against the other.
"""
