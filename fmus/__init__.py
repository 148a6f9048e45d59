"""What is simulated: the equations of Lu & Meng (1991), one file per FMU.

`catalog` lists the units; `arm`, `contact`, `impedance` and `tirt` hold the equations they share.
"""
