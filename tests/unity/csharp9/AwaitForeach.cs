// SPDX-License-Identifier: Apache-2.0
using System.Threading;
using System.Threading.Tasks;
using Ros2Gateway;
using Ros2Gateway.Messages;

/// <summary>A feature that Mono's compiler does not know, and Unity's does.</summary>
public static class AwaitForeach
{
    public static async Task<GoalStatus> Follow(GatewayClient client, CancellationToken token)
    {
        GoalTask<DynamicMessage, DynamicMessage> goal = client.SendGoalAsync<DynamicMessage, DynamicMessage>(
            "/navigate_to_pose", new DynamicMessage(), token);
        int count = 0;
        await foreach (DynamicMessage feedback in goal)
        {
            count += feedback == null ? 0 : 1;
        }
        return count > 0 ? (await goal).Status : GoalStatus.Unknown;
    }
}
