// The queue on the phone: tasks in their order, their pictures, what came of them.
import { done, transact } from "./database.js";

const MOST_RESULTS = 2000; // kept of a site: an hour of a run

/** Put a task at the end; its picture with it. */
export const addTask = (task, picture = null) => transact(["tasks", "pictures"], "readwrite", async (store) => {
  const number = await done(store("tasks").add(task));
  if (picture) await done(store("pictures").put(picture, number));
  return number;
});

/** Tasks of a site from the oldest, without their pictures. */
export const tasksOf = (site_id) => transact(["tasks"], "readonly", (store) => done(store("tasks").index("site_id").getAll(site_id)));

/** The oldest task of a site with its picture; null when nothing waits. */
export const firstTask = (site_id) => transact(["tasks", "pictures"], "readonly", async (store) => {
  const task = await done(store("tasks").index("site_id").get(site_id));
  return task ? { task, picture: (await done(store("pictures").get(task.number))) ?? null } : null;
});

export const noteTry = (task) => transact(["tasks"], "readwrite", (store) => done(store("tasks").put({ ...task, tries: task.tries + 1 })));

/** A task is done: it leaves the queue in the moment in which what came of it is kept. */
export const settle = (task, outcome) => transact(["tasks", "pictures", "results"], "readwrite", async (store) => {
  await done(store("tasks").delete(task.number));
  await done(store("pictures").delete(task.number));
  const { number, ...kept } = task;
  await done(store("results").add({ ...kept, ...outcome }));
});

/** Forget pictures that wait; trajectories are still opened and closed. Of one task when its number is named. */
export const discard = (site_id) => transact(["tasks", "pictures"], "readwrite", async (store) => {
  for (const task of await done(store("tasks").index("site_id").getAll(site_id))) {
    if (task.kind !== "locate") continue;
    await done(store("tasks").delete(task.number));
    await done(store("pictures").delete(task.number));
  }
});

/** What came of a site's tasks, from the oldest; more than some are forgotten. */
export const resultsOf = (site_id) => transact(["results"], "readwrite", async (store) => {
  const results = await done(store("results").index("site_id").getAll(site_id));
  const old = results.splice(0, Math.max(results.length - MOST_RESULTS, 0));
  for (const result of old) await done(store("results").delete(result.number));
  return results;
});

export const forgetResults = (site_id) => transact(["results"], "readwrite", async (store) => {
  for (const number of await done(store("results").index("site_id").getAllKeys(site_id))) await done(store("results").delete(number));
});
