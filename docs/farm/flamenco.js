// A plan as a Flamenco job: a task for each shard, and one that merges. Copy this file to the folder
// `scripts` next to the Manager, and restart it. Workers must share the plan's folder.

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
        task.addCommand(author.Command("exec", { exe: settings.flipmap, args: args }));
        job.addTask(task);
        return task;
    }

    const shards = [];
    for (let shard = 1; shard <= settings.shards; shard++) {
        // A line a second also tells the Manager that a long task is alive.
        shards.push(addTask(`shard-${shard}`,
            ["run", settings.plan, "--shard", `${shard}`, "--progress", "json"]));
    }
    const merge = addTask("merge", ["merge", settings.plan, "-o", settings.out]);
    for (const shard of shards) {
        merge.addDependency(shard);
    }
}
