"""The meaning of frames, derived from the model: dispatch plan, decoder, encoder, exchanges.

`dispatch` plans how a frame is identified, `decoder` executes that plan and reads the fields, `encoder` writes frames,
`exchange` checks whether a frame answers a request, `candidates` lists the messages that a recorded frame can be.

Belongs here: the reference behaviour that every target has to match, and the reasons for which frames and values are
rejected. Imports `model`, and of `language` the notation of numbers.
"""
