#!/bin/bash
# A map by a Slurm array. Copy, name the map and the parts (64 here, in two places), then:
#   id=$(sbatch --parsable slurm.sh)
#   sbatch --dependency=afterok:$id --mem=4G --wrap "vibeam map cases/maps/fig18.toml period --gather --out fig18.h5"
# Parts that are missing at the end: sbatch --array=7,12 slurm.sh. A part computes only what is missing of it.
#SBATCH --array=1-64
#SBATCH --cpus-per-task=1
#SBATCH --mem=1G
#SBATCH --time=04:00:00
#SBATCH --signal=TERM@60
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%A_%a.log
CASE=${CASE:-cases/maps/fig18.toml} NAME=${NAME:-period} OUT=${OUT:-fig18.h5} PARTS=${PARTS:-64}

trap : TERM  # the signal is for the part, which finishes its step; this shell waits for it
srun vibeam map "$CASE" "$NAME" --out "$OUT" --part "$SLURM_ARRAY_TASK_ID/$PARTS"
code=$?
if [ "$code" = 143 ]; then  # out of time, or preempted: what is there is kept
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
