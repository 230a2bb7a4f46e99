#!/usr/bin/env bash
# One shard of a plan as one subjob of a PBS array; the second line merges after the last subjob.
#
#   array=$(qsub -J 1-64 -v PLAN="$PWD/plan.toml" pbs.sh)
#   qsub -N flipmap-merge -W depend=afterany:"$array" -- \
#       "$(command -v flipmap)" merge "$PWD/plan.toml" -o "$PWD/out.png"
#
# Run both again if the merge says that shards are missing: finished ones take a moment. An array has
# at least two subjobs.
#
#PBS -N flipmap
#PBS -J 1-64
#PBS -l select=1:ncpus=4:mem=4gb
#PBS -l walltime=01:00:00
#PBS -j oe
# Run a subjob again whose node has died, or that was preempted.
#PBS -r y
set -u

plan="${PLAN:?usage: qsub -J SHARDS -v PLAN=/path/to/PLAN.toml pbs.sh}"
shard="${PBS_ARRAY_INDEX:?submit me with -J SHARDS}"
export RAYON_NUM_THREADS="${NCPUS:-1}"

# At the time limit, PBS sends SIGTERM to all processes of the subjob and kills them some seconds later
# (the queue's kill_delay). flipmap exits with 75, its progress saved; PBS has no exit code for *again*.
exec "${FLIPMAP:-flipmap}" run "$plan" --shard "$shard"
