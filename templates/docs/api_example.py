import canwright
from canwright import CanFrame, Decoder, Direction, Encoder, Rejection

specification = canwright.load("lamp.yaml")
edition = specification.edition
decoder, encoder = Decoder(edition), Encoder(edition)

reply = decoder.decode(Direction.REPLY, CanFrame(0x102, bytes.fromhex("11 00 F4 01 00 00 00 00")))
if not isinstance(reply, Rejection):
    print(reply.message.name, reply.node, reply.raws, float(reply.values["level"]))

request = edition.command("dim").request
print(encoder.encode_values(request, 3, {"level": 12.5}))
too_much = encoder.encode_values(request, 3, {"level": 101})
if isinstance(too_much, Rejection):
    print(too_much.reason.value, too_much.field)

print([path for path in canwright.generate([specification], ["c"]) if path.endswith("include/lamp/v1.h")])
