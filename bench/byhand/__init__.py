"""Textbook recursions written out by hand for any arithmetic: what a user gets without a robotics toolkit.

Frames stand on the joint axes (Craig, Introduction to Robotics, ch. 3 and 6; Khalil and Dombre, Modeling,
Identification and Control of Robots, ch. 9). The code shares nothing with the derivation that it is compared with.
"""
