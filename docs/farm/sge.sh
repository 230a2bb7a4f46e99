#!/usr/bin/env bash
# One shard of a plan as one task of a Grid Engine array; the second line merges after the last task.
#
#   qsub -t 1-64 sge.sh PLAN.toml
#   qsub -cwd -b y -j y -N flipmap-merge -hold_jid flipmap flipmap merge PLAN.toml -o OUT.png
#
# Run both again if the merge says that shards are missing: finished ones take a moment.
#
#$ -N flipmap
#$ -S /bin/bash
#$ -cwd
#$ -j y
# Four cores a task; ask `qconf -spl` what this is called where you are, then make it a single #:
##$ -pe smp 4
# A warning (SIGUSR1) at this time, and the end some minutes later:
#$ -l s_rt=01:00:00,h_rt=01:05:00
# A warning (SIGUSR2) before the task is killed for any other reason.
#$ -notify
# Run a task again whose node has died.
#$ -r y
set -u

plan="${1:?usage: qsub -t SHARDS sge.sh PLAN.toml}"
shard="${SGE_TASK_ID:?submit me with -t SHARDS}"
export RAYON_NUM_THREADS="${NSLOTS:-1}"

# The warnings reach all processes of the task; here they become the one that flipmap knows.
(trap '' USR1 USR2 && exec "${FLIPMAP:-flipmap}" run "$plan" --shard "$shard") &
flipmap=$!
trap 'kill -TERM "$flipmap" 2>/dev/null' USR1 USR2 TERM
while kill -0 "$flipmap" 2>/dev/null; do sleep 1; done
wait "$flipmap"
code=$?

# 75: stopped, with its progress saved. 143: stopped before it listened. Grid Engine runs a task
# again that exits with 99, unless it was deleted.
if [ "$code" = 75 ] || [ "$code" = 143 ]; then exit 99; fi
exit "$code"
