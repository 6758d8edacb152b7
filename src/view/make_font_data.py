#!/usr/bin/python3
"""Writes font_data.inc: DejaVu Sans as grey bitmaps (needs python3-pil and fonts-dejavu-core).

usage: make_font_data.py > font_data.inc
One row per glyph: code point, advance, width, height, left, top, then width*height grey levels 0-f, row by row.
"""
from PIL import Image, ImageDraw, ImageFont

SIZE = 24
font = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", SIZE)
print("// DejaVu Sans, %d pixels to the em; made by make_font_data.py. Copyright (c) 2003 Bitstream, Inc.; DejaVu changes" % SIZE)
print("// are in the public domain. Fields: code point, advance, width, height, left, top, grey levels.")
for c in [chr(i) for i in range(32, 127)] + list("°±²³µ·×–—…äöüéαβγθσ→"):
    left, top, right, bottom = font.getbbox(c)
    w, h = max(0, right - left), max(0, bottom - top)
    image = Image.new("L", (max(1, w), max(1, h)), 0)
    ImageDraw.Draw(image).text((-left, -top), c, fill=255, font=font)
    levels = "".join("%x" % (v // 16) for v in image.getdata()) if w and h else ""
    print('{%d, %d, %d, %d, %d, %d, "%s"},' % (ord(c), round(font.getlength(c)), w, h, left, top, levels))
