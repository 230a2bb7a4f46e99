#!/usr/bin/env bash
# One shard of a plan as one task of a Grid Engine array; the second line merges after the last task.
#
#   array=$(qsub -terse -t 1-64 sge.sh PLAN.toml)
#   qsub -cwd -b y -j y -hold_jid "${array%%.*}" -N flipmap-merge flipmap merge PLAN.toml -o OUT.png
#
# Run both again if the merge says that shards are missing: finished ones take a moment.
#
#$ -N flipmap
#$ -S /bin/bash
#$ -cwd
#$ -j y
# Four cores a task; `qconf -spl` tells what this is called where you are. Then make it a single #:
##$ -pe smp 4
# The time limit; LIMIT below must stay some minutes under it.
#$ -l h_rt=01:00:00
# A warning (SIGUSR2) before a task is killed.
#$ -notify
# Run a task again whose node has died.
#$ -r y
set -u

plan="${1:?usage: qsub -t SHARDS sge.sh PLAN.toml}"
shard="${SGE_TASK_ID:?submit me with -t SHARDS}"
export RAYON_NUM_THREADS="${NSLOTS:-1}"

# SIGTERM before the time limit comes from here, not from `-l s_rt`: a task that Grid Engine 8.1.9 runs
# again is killed at its s_rt. Warnings reach all processes of the task, and flipmap knows only SIGTERM.
(trap '' USR1 USR2 && exec timeout --preserve-status "${LIMIT:-55m}" \
    "${FLIPMAP:-flipmap}" run "$plan" --shard "$shard") &
flipmap=$!
trap 'kill -TERM "$flipmap" 2>/dev/null' USR1 USR2 TERM
while kill -0 "$flipmap" 2>/dev/null; do sleep 1; done
wait "$flipmap"
code=$?

# 75: stopped, with its progress saved. 143: stopped before it listened. Grid Engine runs a task
# again that exits with 99, unless it is being deleted.
if [ "$code" = 75 ] || [ "$code" = 143 ]; then exit 99; fi
exit "$code"
