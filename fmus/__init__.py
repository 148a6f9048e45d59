"""Adaptive impedance control of robot arms: the equations of Lu and Meng (1991), one file per FMU.

Numbers of equations and sections are those of Lu and Meng, "Impedance Control with Adaptation for
Robotic Manipulations", IEEE Transactions on Robotics and Automation 7(3), 1991. What is assumed beyond
them is called so.

The folders mechanics, environment and control hold the equations that the FMUs share.
"""
