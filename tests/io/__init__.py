# ruff: noqa: A005  (mirrors src/uvshear/io)
