"""`make words`: brings the catalogues up to date with the sources and lists what needs words."""

import sys

from service.languages.update import update

missing = update()
for text in missing:
    print(text)
print(f"{len(missing)} messages need a translation: write it into service/languages/*.po" if missing else "Complete.")
sys.exit(bool(missing))
