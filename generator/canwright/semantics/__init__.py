"""What a frame means, from the model alone: dispatch plan, decoder, encoder, exchanges.

`dispatch` decides which message a frame is, `decoder` executes that plan and reads the fields, `encoder` writes frames,
`exchange` checks whether a frame answers a request, `candidates` lists what a recorded frame can be.

Belongs here: the reference behaviour that every target has to match, and the reasons for which frames and values are
rejected. Imports `diagnostics`, `model` and the notation of `language`.
"""
