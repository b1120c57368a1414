"""The physics over any scalar type: chain of joint frames, one recursion per quantity."""
