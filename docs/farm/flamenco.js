// A plan as a Flamenco 3 job: a task for each shard, and one that merges. Copy this file as
// scripts/flipmap.js next to the Manager, and restart it. Workers must share the plan's folder. Then:
//
//   curl http://MANAGER:8080/api/v3/jobs --json '{"name": "flipmap", "type": "flipmap",
//     "priority": 50, "submitter_platform": "linux",
//     "settings": {"plan": "/farm/plan.toml", "shards": 64, "out": "/farm/out.png"}}'

const JOB_TYPE = {
    label: "flipmap",
    settings: [
        { key: "plan", type: "string", subtype: "file_path", required: true,
          description: "Plan written by `flipmap plan`" },
        { key: "shards", type: "int32", required: true, description: "Number of the plan's shards" },
        { key: "out", type: "string", subtype: "file_path", required: true,
          description: "Picture or film to write" },
        { key: "flipmap", type: "string", default: "flipmap",
          description: "The program, where every Worker finds it" },
    ],
};

function compileJob(job) {
    const settings = job.settings;

    function addTask(name, args) {
        const task = author.Task(name, "misc");
        task.addCommand(author.Command("exec", { exe: settings.flipmap || "flipmap", args: args }));
        job.addTask(task);
        return task;
    }

    const shards = [];
    for (let shard = 1; shard <= settings.shards; shard++) {
        // A line a second keeps a long task from timing out.
        shards.push(addTask(`shard-${shard}`,
            ["run", settings.plan, "--shard", `${shard}`, "--progress", "json"]));
    }
    const merge = addTask("merge", ["merge", settings.plan, "-o", settings.out]);
    for (const shard of shards) {
        merge.addDependency(shard);
    }
}
