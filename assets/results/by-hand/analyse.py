import glob, json
import numpy as np, pandas as pd
from rliable import library as rly, metrics
from scipy.stats import binomtest
from statsmodels.stats.contingency_tables import mcnemar
from statsmodels.stats.multitest import multipletests

df = pd.DataFrame(json.load(open(f)) for f in glob.glob("runs/*/result.json"))
df["solved"] = df.first_optimal_episode.notna()
df["until"] = df.first_optimal_env_steps.fillna(np.inf)
rows = []
for world, one in df.groupby("world"):
    ours, theirs = (one[one.method == m].set_index("seed").sort_index() for m in ["xcscr", "q-learning"])
    assert list(ours.index) == list(theirs.index)
    table = pd.crosstab(ours.solved, theirs.solved).reindex(index=[False, True], columns=[False, True], fill_value=0)
    sooner, later = int((ours.until < theirs.until).sum()), int((ours.until > theirs.until).sum())
    rows.append([world, table.values[1, 0] - table.values[0, 1], mcnemar(table.values, exact=True).pvalue, sooner, later,
                 binomtest(sooner, sooner + later).pvalue])
r = pd.DataFrame(rows, columns=["world", "more solved", "share p", "sooner", "later", "steps p"])
for p in ["share p", "steps p"]:
    r[p + " holm"] = multipletests(r[p], method="holm")[1]
print(r.to_string())
for (world, method), one in df.groupby(["world", "method"]):
    steps = one.first_optimal_env_steps.fillna(one.steps).to_numpy()[:, None]
    score, interval = rly.get_interval_estimates({method: steps}, lambda x: np.array([metrics.aggregate_iqm(x)]), reps=2000)
    print(world, method, int(one.solved.sum()), score[method].round(0), interval[method].round(0).ravel())
