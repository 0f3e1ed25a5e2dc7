#!/bin/sh
# Without arguments the service; with arguments any other command of imu-health, for instance `db upgrade`.
set -eu
if [ "$#" -eq 0 ]; then set -- serve; fi
exec imu-health "$@"
