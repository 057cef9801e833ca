"""The plan of an edition: what its frames mean, derived once from the model and in terms of no language.

- `dispatch`: which message a frame is;
- `plan`: the steps of decoding and encoding a message, with their order; accepted keys and reserved bits;
- `valid_raws`: the raw integers that a type allows;
- `exchange`: which replies answer which request;
- `decoder`, `encoder`: the reference, which executes the plan, with reasons for rejection.

Belongs here: every fact about frames that more than one target needs. Imports the model alone.
"""
