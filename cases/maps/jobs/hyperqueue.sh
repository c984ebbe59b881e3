#!/bin/bash
# A map by HyperQueue, whose workers come and go. Copy, name the map and the parts (64 here, in two places), then:
#   hq submit --wait hyperqueue.sh && vibeam map cases/maps/fig18.toml period --gather --out fig18.h5
# A part whose worker is lost is run again by the server. One that was told to end fails with code 143 and keeps what
# is there: the same line computes what is missing, and parts that are complete end at once.
#HQ --array 1-64
#HQ --cpus 1
#HQ --crash-limit 100
CASE=${CASE:-cases/maps/fig18.toml} NAME=${NAME:-period} OUT=${OUT:-fig18.h5} PARTS=${PARTS:-64}

exec vibeam map "$CASE" "$NAME" --out "$OUT" --part "$HQ_TASK_ID/$PARTS"
