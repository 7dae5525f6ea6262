// SPDX-License-Identifier: Apache-2.0
// Which cards there are, by the view that the address of the page names.

import { isView } from "../../views/views.js";
import { CallCard } from "./call_card.js";
import { ConnectionCard } from "./connection_card.js";
import { DriveCard } from "./drive_card.js";
import { GoalCard } from "./goal_card.js";
import { GraphCard } from "./graph_card.js";
import { NodeCard } from "./node_card.js";
import { ParametersCard } from "./parameters_card.js";
import { PublishCard } from "./publish_card.js";
import { SceneCard } from "./scene_card.js";
import { TopicCard } from "./topic_card.js";

const KINDS = { drive: DriveCard, publish: PublishCard, call: CallCard, goal: GoalCard, node: NodeCard, parameters: ParametersCard, graph: GraphCard, scene: SceneCard, connection: ConnectionCard };

/** Return whether there is a card for a view. An old address may have others. */
export const isKnown = (view) => Object.hasOwn(KINDS, view) || isView(view);

/**
 * Make a card.
 * @param {import("../../shared/gateway.js").Gateway} gateway
 * @param {import("./card.js").Shown} shown
 * @param {import("./card.js").Actions} actions
 * @returns {import("./card.js").Card}
 */
export function makeCard(gateway, shown, actions) {
  const Kind = Object.hasOwn(KINDS, shown.view) ? KINDS[shown.view] : TopicCard;
  return new Kind(gateway, shown, actions);
}
