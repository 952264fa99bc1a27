"""Estimated errors against true ones; renews their section of benchmarks/README.md.

    python benchmarks/estimates/run.py [WORD ...]

With words only scenes that have one in their names, printed alone.
"""

import re
import sys
from pathlib import Path

from battery import run_all, table

PAGE = Path(__file__).resolve().parents[1] / "README.md"
SECTION = re.compile("(<!-- estimates -->\n).*(<!-- end of estimates -->\n)", re.DOTALL)

if __name__ == "__main__":
    words = sys.argv[1:]
    text = table(run_all(words))
    print(text)
    if words:
        sys.exit()
    page = PAGE.read_text("utf-8")
    PAGE.write_text(SECTION.sub(lambda m: f"{m[1]}\n{text}\n\n{m[2]}", page), "utf-8")
