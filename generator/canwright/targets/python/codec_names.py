"""What an edition's module may need of `_codec`."""

NAMES = (
    *("Bound", "CodecError", "Float", "Message", "Number", "Real", "Refusal", "Reply", "Request"),
    *(
        "Reader",
        "Route",
        "Router",
        "ToAll",
        "ToNode",
        "constant",
        "each",
        "flags",
        "known",
        "member",
        "merge",
        "missing",
        "named",
    ),
    *("node_in", "not_answer", "require"),
)
