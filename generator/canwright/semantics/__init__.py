"""What a frame means, from the model alone: dispatch plan, decoder, encoder, exchanges.

Belongs here: the reference behaviour that every target has to match, and the reasons for which frames and values are
rejected. Imports `diagnostics`, `model` and the notation of `language`.
"""
