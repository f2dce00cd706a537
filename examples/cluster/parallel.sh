#!/usr/bin/env bash
# A study under GNU parallel, on this machine or, with --sshloginfile, on several:
#
#   parallel.sh STUDY TASKS DIR [OPTION OF parallel]...
set -euo pipefail
study=$1 tasks=$2 dir=$(realpath -m "$3")
shift 3
xcscr study plan "$study" --tasks "$tasks" --out "$dir"
seq "$tasks" | parallel --retries 3 "$@" xcscr study task "$dir" {} --jobs 1 --quiet
xcscr study report "$dir"
