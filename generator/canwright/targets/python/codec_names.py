"""What an edition's module may need of `_codec`."""

PUBLIC = ("CodecError", "FieldAbsent", "Message", "Refusal", "Reply", "Request")
"""What a program needs beside the classes of an edition; every module hands it on."""

NAMES = (
    *PUBLIC,
    *("Bound", "Float", "Number", "Real"),
    *(
        "Reader",
        "Route",
        "Router",
        "ToAll",
        "ToNode",
        "check_choice",
        "check_number",
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
