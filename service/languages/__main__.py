"""`make words`: updates the catalogues from the sources and lists untranslated messages."""

import sys

from service.languages.update import update

missing = update()
for text in missing:
    print(text)
print(f"{len(missing)} messages need a translation: write it into service/languages/*.po" if missing else "Complete.")
sys.exit(bool(missing))
