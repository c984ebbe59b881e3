#!/bin/bash
# A map by GNU parallel over machines that share a folder: one part at a time on each, which takes all of its cores.
# Copy, name the map, and run it where the folder is: HOSTS=hosts.txt ./parallel.sh (a name a line; ":" is this one).
# Told to end, each part finishes its step; the same line then computes what is missing.
CASE=${CASE:-cases/maps/fig18.toml} NAME=${NAME:-period} OUT=${OUT:-fig18.h5} PARTS=${PARTS:-64}

parallel --jobs "${JOBS:-1}" ${HOSTS:+--sshloginfile "$HOSTS" --workdir .} --retries 3 --termseq TERM,60000,KILL \
    --joblog "$OUT.log" vibeam map "$CASE" "$NAME" --out "$OUT" --part "{}/$PARTS" ::: $(seq "$PARTS") &&
    vibeam map "$CASE" "$NAME" --out "$OUT" --gather
