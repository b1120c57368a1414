"""Operations counted in one way for all: multiplications, additions, divisions, and sines and cosines."""
