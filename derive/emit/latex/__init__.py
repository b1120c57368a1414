"""Mathematics in the notation of lecture notes: how it is written, how wide it is, where its lines break."""
