"""``accuracy = "1 %"``: the cheapest model and solver, frequency by frequency, that stay within it.

``known`` has the closed-form motions of one model over the whole sweep; ``rungs`` reads off one model's motions where
it is asked; ``track`` follows the finest model as a sweep would, by formula where a stable motion goes on and by flight
where none does; ``ladder`` settles for a cheaper model between frequencies where it was seen to be good enough;
``unsettled`` does so by statistics where nothing repeats; ``verify`` flies the finest model at random points;
``study`` puts them together.
"""
