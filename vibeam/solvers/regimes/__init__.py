"""Piecewise linear motion in general: any damping, any contact law, one stop or two; beside the flight kernels.

A regime is a linear system η = held + from·y, y' = A y + constant + load Ω²B sin φ with A in real 2×2 blocks, an event
is the root of a row over y, and a law is a map between regimes. Free flight, rest on the stop and contact with a linear
stop differ in their matrices alone. Only a stop that is not linear is integrated, and only while it is touched.

Every scalar row·y of a block obeys x'' + 2σx' + ω²x = 0 (Cayley and Hamilton), which is all that the flight kernels'
root isolator asks of a pair: it is used as it is.
"""
