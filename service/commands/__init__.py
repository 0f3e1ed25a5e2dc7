"""The commands of `imu-health`, one a file; `service.cli` joins them."""
