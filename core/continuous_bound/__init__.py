"""A lower bound of the energy of every driving of a train over a line, continuous in place, and a mesh that meets it.

Read `bound` first: the inequality, which holds whatever the prices. `prices` takes these from the multipliers of an
optimum over a mesh, `hamiltonian` finds the least over all speeds and efforts at a place from the table that
`drive_rows` makes of a drive, and `refinement` cuts the mesh where run and bound differ.
"""
