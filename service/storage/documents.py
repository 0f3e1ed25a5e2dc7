"""The codec of what the service keeps: that of the estimator with the parts of messages, and moments as ISO 8601."""

from datetime import datetime

from estimator.codec import WITH_PARTS, Codec, Form

STORED = Codec({datetime: Form(datetime.isoformat, datetime.fromisoformat), **WITH_PARTS})
