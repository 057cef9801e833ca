"""The checksum of a frame in the language."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, ClassVar

from ..model.checksum import AlgorithmName
from .concept import Concept, Doc, JsonSchema, Limits, Problem
from .scalar_types import Byte, ChecksumInput

_WORDS = ("refin", "refout", "reflect_in", "reflect_out", "ref_in", "ref_out")


@dataclass(frozen=True, eq=False, kw_only=True)
class ChecksumSpec(Concept):
    """The checksum of other bytes of the frame: a named algorithm, or a CRC by its parameters. Its width is that of the field."""

    called = "a checksum"
    example = {"algorithm": "crc8_sae_j1850", "over": "0..6"}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": ["algorithm"]}, {"required": ["poly"]}]}
    advice = {
        **dict.fromkeys(_WORDS, "write `reflected: true` if bytes enter and the result leaves with bit 0 first"),
        **dict.fromkeys(("xorout", "xor", "final_xor"), "write `xor_out`"),
        **dict.fromkeys(("polynomial", "generator"), "write `poly`"),
        "width": "omit it; the width is that of the field",
        "data_id": 'write its bytes in `over`, in quotes: over: ["34 12", 1..7]',
    }

    algorithm: Annotated[
        AlgorithmName | None,
        Doc(
            "The algorithm: a CRC of the public catalogues, the sum of all bytes (`sum`, its complement `sum_inverted`, or "
            "`sum_negated`, which makes the sum with the checksum 0), or their exclusive or."
        ),
    ] = None
    poly: Annotated[Byte | None, Doc("Polynomial of a CRC without its highest bit: 0x1D.", examples=(0x1D,))] = None
    init: Annotated[Byte, Doc("Initial value of the CRC, as catalogues state it.")] = 0
    reflected: Annotated[
        bool, Doc("True if bytes enter and the result leaves with bit 0 first (refin and refout).")
    ] = False
    xor_out: Annotated[Byte, Doc("Applied to the result with exclusive or.")] = 0
    over: Annotated[
        Annotated[list[ChecksumInput], Limits(min_length=1, max_length=64)] | ChecksumInput,
        Doc(
            "The bytes, in this order: data bytes `0..6`, the `id` (2 bytes, or 4 of a 29-bit id, in the byte order of the "
            "field), its lowest byte `id_low`, and constant bytes in hex, such as a data id, in quotes. Bits of the checksum itself count as 0.",
            examples=("0..6", ["34 12", "1..7"], ["id", "0..6"], ["id_low", "0..6"]),
        ),
    ]

    def problems(self, name: str) -> Iterable[Problem]:
        if (self.algorithm is None) == (self.poly is None):
            both = "both `algorithm` and `poly`" if self.algorithm else "neither `algorithm` nor `poly`"
            hint = "write the name of an algorithm, or the parameters of a CRC: poly: 0x1D, init: 0xFF, xor_out: 0xFF"
            yield Problem((), "checksum-parameters", f"`{name}` has {both}", hint)
        elif self.algorithm and (self.init or self.reflected or self.xor_out):
            text = f"`{self.algorithm}` has parameters of its own"
            hint = "omit `init`, `reflected` and `xor_out`, or write `poly` instead of `algorithm`"
            yield Problem(("algorithm",), "checksum-parameters", text, hint)
