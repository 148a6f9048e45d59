"""What is simulated: the equations of Lu & Meng (1991), one file per FMU.

Numbers of equations and sections are those of Lu and Meng, "Impedance Control with Adaptation for
Robotic Manipulations", IEEE Transactions on Robotics and Automation 7(3), 1991. What is assumed beyond
them is called so.

`catalog` lists the units; `arm`, `contact`, `impedance` and `tirt` hold the equations they share.
"""
