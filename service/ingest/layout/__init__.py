"""Tables of custom layout: previewed, recognised, mapped by hand where needed, and read as a session.

envelope    the uploaded bytes and their mapping in one file: what is stored
decoding    bytes of text → text            cutting  text → rows
times       dates and times of day → seconds
sampling    a long text → its beginning and later places
grids       any table → cells, headings
pivoting    one sensor a row → sensors side by side
titles      rows above a table → facts      vocabulary, senses   words of headings, in four languages
evidence    what values say                 triads, understand   headings and values → columns of a mapping
kinds       kinds of columns                facts    columns and values → facts of a session
mapping     `imu-mapping/1`, checked        reading  cells under a mapping → imu-session/1
scanning    a long text under a mapping, in parts
look        what a preview shows of a file
"""
