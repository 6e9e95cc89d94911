"""Rules on people: zones, lines, edges, speeds and postures, each judged with its uncertainty.

Everything here is pure: a rule sees nothing but snapshots, in their order, so the same recording
always gives the same events. The rules are advisory; they are no certified safety function.
"""
