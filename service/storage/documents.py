"""The codec of what the service keeps: that of the estimator, with moments as ISO 8601."""

from datetime import datetime

from estimator.codec import Codec, Form

STORED = Codec({datetime: Form(datetime.isoformat, datetime.fromisoformat)})
