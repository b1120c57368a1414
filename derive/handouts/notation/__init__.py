"""Mathematics in the notation of lecture notes: how it is written and how wide it is."""
