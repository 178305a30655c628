"""What the papers are called."""

AUTHORS = {"ftorek": "Ftorek", "liashenko": "Liashenko", "rawicki": "Rawicki", "shtompel": "Shtompel"}
